"""Every message at the edge as a strict pydantic model, one module per resource."""
