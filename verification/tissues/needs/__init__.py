"""What a scene needs: the simplest models that answer questions as the full model does."""
