"""The mean-field limit of chapter 5: rates of W1, orders, drift of the constraint and of the energy."""
