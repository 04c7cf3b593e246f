"""Parts that both tabs need: the player and its streams, tables and charts, the folder of files."""
