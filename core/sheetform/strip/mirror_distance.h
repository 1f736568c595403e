// A half of a symmetric result measured as what it becomes: together with its mirror image.
#pragma once
#include "sheetform/strip/certificate.h"

namespace sheetform {

/// find_far() between `whole` and the half x >= 0 with its mirror image in x = 0, told as of the half: the
/// error of a patch is the larger one of it and of its image, and places of the image are mirrored back,
/// point numbers and all. What has to be nearer on either side is thus known of the half. worst_place is
/// where it was found. tree, over_whole: of the faces of `whole`, which need not be symmetric. Cost that of
/// find_far().
DistanceReport find_far_with_image(const TriangleSoup& whole, const ClosestPointTree& tree,
                                   const HeightBound& over_whole, const StripMesh& half, double limit,
                                   RunContext& context);

/// measure_normals() in the same way.
NormalReport measure_normals_with_image(const TriangleSoup& whole, const ClosestPointTree& tree,
                                        const StripMesh& half, int samples, RunContext& context);

}  // namespace sheetform
