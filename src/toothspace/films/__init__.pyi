from toothspace.films.public import *  # noqa: F403
