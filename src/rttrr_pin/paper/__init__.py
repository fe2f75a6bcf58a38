"""Published equations: read, held term by term against the recursion, and set right."""
