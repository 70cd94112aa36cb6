"""How much human proxies are like the people they were made from: measures, gates, tables and pictures."""
