"""The load-case matrix: from a table of metocean cases to one data set."""
