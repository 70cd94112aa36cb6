"""Scores agents: protocols, episodes and the database that stores them, statistics, tables and reports."""
