"""Makers of appliances, sanitary ware and screens, and the rows of the default set."""
