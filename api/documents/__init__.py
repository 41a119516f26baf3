"""The documents that describe the interface: OpenAPI for requests, AsyncAPI for the stream.

Both are made from the models that check and make what goes over the wire, and shown with examples
that a test asks for and compares.
"""
