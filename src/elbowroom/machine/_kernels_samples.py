"""Samples of triangles, and what they enclose: arrays in, arrays out."""

import math

import numpy as np
from numba import njit
