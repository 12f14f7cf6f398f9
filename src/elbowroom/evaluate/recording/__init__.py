"""Whether recordings keep up, open wherever they are cut off, and are judged again to the same bits."""
