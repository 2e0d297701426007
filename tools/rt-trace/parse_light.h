#pragma once
#include "tools/rt-trace/lights.h"

#include <string>

namespace rt {

/// A light of the command line:
///     [point:]X,Y,Z
///     directional:DX,DY,DZ                    the way that light goes
///     spot:X,Y,Z,TX,TY,TZ,OUTER,INNER         shines towards T; half angles of its cone, degrees
///     rectangle:X,Y,Z,TX,TY,TZ,WIDTH,HEIGHT   of its centre; faces T, its width is level
///     sphere:X,Y,Z,RADIUS
/// each with ,R,G,B behind it or not. Throws Error{Usage}.
LightRequest parseLight(const std::string& text);

} // namespace rt
