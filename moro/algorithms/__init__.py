"""Textbook algorithms, each written once over any scalar."""
