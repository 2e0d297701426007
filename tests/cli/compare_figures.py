"""compare_figures.py A.pfm B.pfm: prints the figures of rt-compare once more, by numpy, as JSON."""
import json
import sys

import numpy


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline().strip() == b"PF"
        width, height = map(int, file.readline().split())
        kind = "<f4" if float(file.readline()) < 0 else ">f4"
        return numpy.frombuffer(file.read(), kind).reshape(height, width, 3)[::-1].astype(numpy.float64)


def figures(a, b):
    error = numpy.abs(a - b)
    mse = numpy.mean(error**2)
    return {
        "maxAbs": error.max(),
        "bias": numpy.mean(a - b),
        "mae": error.mean(),
        "mse": mse,
        "rmse": numpy.sqrt(mse),
        "relMse": numpy.mean(error**2 / (b**2 + 0.01)),
        "smape": numpy.mean(error / (numpy.abs(a) + numpy.abs(b) + 0.01)),
        "psnr": 10 * numpy.log10(1 / mse),
        "percentiles": [numpy.percentile(error, p, method="inverted_cdf") for p in (50, 90, 99, 99.9)],
        "over": [int((error.reshape(-1, error.shape[-1]).max(axis=1) > t).sum()) for t in (0, 1e-3, 1e-2, 1e-1)],
        "meanA": a.mean(),
        "minB": b.min(),
    }


a, b = map(read_pfm, sys.argv[1:3])
result = {"all": figures(a, b)}
for channel, name in enumerate("RGB"):
    result[name] = figures(a[..., channel : channel + 1], b[..., channel : channel + 1])
json.dump(result, sys.stdout, default=float)
