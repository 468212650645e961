from toothspace.films.public import *
