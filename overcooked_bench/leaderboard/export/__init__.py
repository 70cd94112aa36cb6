"""Turns models of other libraries into submissions, without unpickling anything of them."""
