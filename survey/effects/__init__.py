"""What each effect of a scenario costs: the mission flown anew with one of them left out."""
