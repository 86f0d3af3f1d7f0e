"""Archives changed by somebody who made their checksums right."""

import json

import numpy as np


def rewritten(saved, path, change):
    """The archive with its arrays and header changed, and all checksums right."""
    with np.load(saved) as file:
        arrays = {name: file[name] for name in file.files}
    header = json.loads(bytes(arrays.pop("header")))
    change(header, arrays)
    arrays["header"] = np.frombuffer(json.dumps(header).encode(), np.uint8)
    np.savez(path, **arrays)


def put(name, index, value):
    def change(_header, arrays):
        arrays[name] = arrays[name].copy()
        arrays[name][index] = value

    return change


def swap(name, make):
    return lambda _header, arrays: arrays.update({name: make(arrays[name])})


def say(*keys, value):
    def change(header, _arrays):
        for key in keys[:-1]:
            header = header[key]
        header[keys[-1]] = value

    return change
