"""In which order the parts go together: found by taking the robot apart along straight lines."""
