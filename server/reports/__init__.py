"""The report of a job: one document for the file, as HTML and as PDF.

``material`` reads what is known of a job, ``build`` makes the document of it, two writers write it.
Nothing is imported here: the process that writes PDF needs its writer alone.
"""
