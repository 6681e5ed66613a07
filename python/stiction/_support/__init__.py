"""What every part of the package stands on: words, arguments, files, progress, threads."""
