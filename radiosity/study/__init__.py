"""Error against run time and memory, over methods, patches, bounces and solvers; stiff and extreme cases.

`radiosity study` and `radiosity stress` are the doors. From Python:

>>> from radiosity.study.study import Settings, run_study  # doctest: +SKIP
>>> run_study(subjects, Settings.quick(), "study_cornell")  # doctest: +SKIP
"""
