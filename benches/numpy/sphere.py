"""The course's first scene as a NumPy loop over the pixels: sphere.py WIDTH HEIGHT OUT.png

Written for the race with raycost, one pixel after the other, like a first ray tracer. tests/numpy/seed_model.py is the model for any scene, and renders all pixels at once.
"""

import sys

import numpy as np
from PIL import Image

EYE = np.array([0.0, 0.0, -1.0])
LIGHT = np.array([5.0, 5.0, -10.0])
CENTER = np.array([0.0, 0.0, 1.0])
RADIUS = 1.0
COLOR = np.array([0.0, 0.0, 1.0])
AMBIENT = 0.05
DIFFUSE = 1.0
SPECULAR = 1.0
EXPONENT = 50


def normalized(vector):
    return vector / np.linalg.norm(vector)


def distance_to_sphere(origin, direction):
    """How far the sphere is along the ray; infinite for a miss."""
    to_origin = origin - CENTER
    b = np.dot(direction, to_origin)
    c = np.dot(to_origin, to_origin) - RADIUS**2
    discriminant = b * b - c
    if discriminant > 0:
        root = np.sqrt(discriminant)
        for distance in (-b - root, -b + root):
            if distance > 0:
                return distance
    return np.inf


def color_along(origin, direction):
    """Blinn and Phong's shading of the sphere; black for a miss."""
    distance = distance_to_sphere(origin, direction)
    if np.isinf(distance):
        return np.zeros(3)
    point = origin + distance * direction
    normal = normalized(point - CENTER)
    to_light = normalized(LIGHT - point)
    to_eye = normalized(EYE - point)
    color = AMBIENT + DIFFUSE * max(np.dot(normal, to_light), 0) * COLOR
    half = normalized(to_light + to_eye)
    return color + SPECULAR * max(np.dot(normal, half), 0) ** EXPONENT


def picture(width, height):
    """Colours from 0 to 1, row 0 on top."""
    pixels = np.zeros((height, width, 3))
    for j, y in enumerate(np.linspace(1, -1, height)):
        for i, x in enumerate(np.linspace(-1, 1, width)):
            direction = normalized(np.array([x, y, 0.0]) - EYE)
            pixels[j, i] = color_along(EYE, direction)
    return np.clip(pixels, 0, 1)


if __name__ == "__main__":
    width, height, out = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
    Image.fromarray(np.round(255 * picture(width, height)).astype(np.uint8)).save(out)
