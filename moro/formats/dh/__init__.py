"""Rows of Denavit-Hartenberg parameters.

rows          rows as a person writes them
arm           what is given, as exact values
description   what is given, checked as it is set
meanings      where symbols are in what was given
to_model      both conventions brought to a Model
"""
