"""The case editor: one YAML text, which the form reads and changes; nothing here asks the service anything."""
