#include "sheetform/search/outline_samples.h"

#include <gtest/gtest.h>

#include "unit/search/drawn_surface.h"

namespace sheetform {
namespace {

using shapes::Drawing;
using shapes::drawn;

EvaluationParams sparse(double sparsest) {
  EvaluationParams params = evaluation_params(0.02);
  params.sparsest = sparsest;
  return params;
}

// Two patches of a cylinder around the vertical axis, side by side.
struct Halves {
  Drawing drawing = drawn("AB/AB/AB/AB", bent(0.7));
  SearchBed bed{drawing.mesh};
  PatchLayout layout = drawing.layout({});
  const Arch* between = nullptr;
  const Arch* across = nullptr;  // an arch of the border that turns around the axis
  Halves() {
    for (const Arch& a : layout.arches) {
      if (a.left >= 0 && a.right >= 0) between = &a;
      const Vector3 d = drawing.mesh.points[a.vertices.back()] - drawing.mesh.points[a.vertices.front()];
      if (a.right == Arch::kOutside && std::abs(d.z()) < 1e-9) across = &a;
    }
  }
};

TEST(OutlineSamples, AreEvenWhenAskedFor) {
  const Halves h;
  for (const Arch& a : h.layout.arches)
    EXPECT_EQ(outline_samples(h.bed.surface, a, sparse(1)), sample_arch(h.drawing.mesh, a, 0.05));
}

TEST(OutlineSamples, AreFewAlongTheRulingsAndManyAcross) {
  const Halves h;
  ASSERT_NE(h.between, nullptr);
  ASSERT_NE(h.across, nullptr);
  EXPECT_EQ(outline_samples(h.bed.surface, *h.between, sparse(0.12)).size(), 3u) << "0.8 long, straight";
  EXPECT_EQ(outline_samples(h.bed.surface, *h.across, sparse(0.12)).size(),
            sample_arch(h.drawing.mesh, *h.across, 0.05).size());
}

TEST(OutlineSamples, ArePlainOnSingleArches) {
  const Halves h;
  ASSERT_NE(h.between, nullptr);
  ASSERT_NE(h.across, nullptr);
  EvaluationParams params = sparse(0.12);
  params.plain_arches = {h.between->key};
  params.plain_spacing = 0.1;
  EXPECT_EQ(outline_samples(h.bed.surface, *h.between, params), sample_arch(h.drawing.mesh, *h.between, 0.1));
  EXPECT_EQ(outline_samples(h.bed.surface, *h.across, params),
            outline_samples(h.bed.surface, *h.across, sparse(0.12)));
}

TEST(OutlineSamples, FollowTheArchWithinATenthOfTheTolerance) {
  shapes::Canvas wave;  // a plane, so that no rulings end anywhere, with waves for borders
  wave.steps = 24;
  wave.place = [](double x, double y) { return Vector3(x, y + 0.1 * std::sin(6 * x), 0); };
  const Drawing d = drawn("A", wave);
  SearchBed bed(d.mesh);
  CurvatureField flat;
  flat.k_max.assign(d.mesh.points.size(), 0);
  bed.surface.curvature = &flat;
  const PatchLayout layout = d.layout({});
  for (double e_max : {0.1, 0.02}) {
    EvaluationParams params = sparse(0.12);
    params.e_max = e_max;
    params.spacing = 0.01;
    for (const Arch& arch : layout.arches) {
      const std::vector<double> at = outline_samples(bed.surface, arch, params);
      EXPECT_EQ(at.front(), 0);
      EXPECT_EQ(at.back(), static_cast<double>(arch.edges.size()));
      EXPECT_LT(at.size(), 0.6 * arch.length / params.spacing) << "flat: few will do";
      for (std::size_t s = 0; s + 1 < at.size(); ++s) {
        ASSERT_LT(at[s], at[s + 1]);
        const Vector3 a = arch_point(d.mesh, arch, at[s]), b = arch_point(d.mesh, arch, at[s + 1]);
        if ((b - a).norm() < 1.5 * params.spacing) continue;
        for (double t = at[s]; t < at[s + 1]; t += 0.1)
          EXPECT_LE(distance_to_triangle(arch_point(d.mesh, arch, t), a, b, b), 0.1 * e_max + 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace sheetform
