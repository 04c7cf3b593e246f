"""Examples of tissue: what a scene needs, three dimensions, curved layers."""
