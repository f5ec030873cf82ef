"""Design -> Robot: the one place where actuators, links and base become bodies with masses and inertias."""
