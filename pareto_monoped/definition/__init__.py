"""What a study is: its file, variables, goals and algorithm settings, as checked records."""
