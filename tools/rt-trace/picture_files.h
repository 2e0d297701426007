#pragma once
#include "formats/image.h"
#include "formats/recipe.h"
#include "tools/rt-trace/film.h"
#include "tools/rt-trace/options.h"

namespace rt {

/// Makes the colours show what pixels cost, see heatColor(): linear light, so that a PNG and an EXR show the
/// same. Returns the figure that is shown in yellow: `most`, or, where that is 0, the picture's largest, of
/// times what 99 % of the pixels do not exceed. The
/// film must have had the extra AOVs.
double paintHeat(FilmPixels& pixels, Heat heat, double most);

/// The image as a PNG is to show it: without alpha, exposed and tone mapped.
Image forScreen(Image image, ToneMap map, double exposureStops);

/// Writes the image under each name; PNGs get what forScreen() gives. All are encoded before the first is
/// written: a picture that cannot be encoded leaves no other one behind.
/// The image has the recipe's mark, see addRecipes().
void writePictures(const std::vector<std::string>& paths, const Image& image, ToneMap map,
                   double exposureStops, const Recipe& recipe = {});

} // namespace rt
