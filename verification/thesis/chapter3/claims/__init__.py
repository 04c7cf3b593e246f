"""Claims of the thesis, one file for each part; file names begin with the section."""
