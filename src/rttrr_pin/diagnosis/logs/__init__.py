"""Logs of real robots: residuals by joint, and what explains most of them."""
