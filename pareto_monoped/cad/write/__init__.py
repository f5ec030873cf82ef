"""One module per file format, and the folder that they are written to."""
