"""Measures of contact graphs: edges, attachments, heights of supporting planes."""
