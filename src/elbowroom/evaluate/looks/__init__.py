"""How often looks at input are right: silent on rooms that are as they should be, loud on each kind that is wrong."""
