"""The model, as chapters 3 and 4 have it: an idea a file, its formula beside the compiled code that carries it out."""
