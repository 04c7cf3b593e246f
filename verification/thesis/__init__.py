"""What this source says: its statements, the studies that decide them, and the pages about them."""
