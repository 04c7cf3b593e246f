"""The tissue in three dimensions: x along it, y the height above the basal layer, z the depth."""
