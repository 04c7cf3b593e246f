"""What defines a model, its derivatives, and the state it starts from."""
