"""What the report and the static plots share: triangulation, sections, thinning, numbers. Not public."""
