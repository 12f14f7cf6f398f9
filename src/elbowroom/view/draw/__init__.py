"""Pictures and files of volumes, images and sites."""
