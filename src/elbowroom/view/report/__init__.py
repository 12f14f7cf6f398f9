"""Reports on the screen and as a page: blocks, tables, charts."""
