"""The library: parts of studies by value, those that come with the program and how any is read."""
