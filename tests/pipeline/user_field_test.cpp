// Rulings follow a field that the user gives.
#include "pipeline/run.h"

namespace sheetform {
namespace {

UserField everywhere(const TriangleSoup& soup, const Vector3& direction) {
  UserField field;
  field.per_face.assign(soup.faces.size(), direction);
  return field;
}

// Share of the rulings' length within 15 degrees of an arm of the cross.
double following(const StripMesh& strips, const Vector3& direction, const Vector3& other) {
  double near = 0, all = 0;
  for (const StripMesh::Patch& p : strips.patches)
    for (const auto& r : p.rulings) {
      const Vector3 d = strips.points[r[1]] - strips.points[r[0]];
      const double along = std::max(std::abs(d.dot(direction)), std::abs(d.dot(other)));
      all += d.norm();
      if (along > std::cos(15 * shapes::kPi / 180) * d.norm()) near += d.norm();
    }
  return all > 0 ? near / all : 0;
}

TEST(UserField, RulingsOfAPlaneFollowIt) {
  const TriangleSoup soup = shapes::plane(10);
  DecomposeParams params;
  params.effort = Effort::kDraft;
  for (double degrees : {0.0, 30.0}) {
    const double a = degrees * shapes::kPi / 180;
    const Vector3 direction(std::cos(a), std::sin(a), 0), other(-std::sin(a), std::cos(a), 0);
    const UserField field = everywhere(soup, direction);
    const Decomposition d = run(soup, params, 2, &field);
    expect_sound(soup, d);
    EXPECT_EQ(d.strips.patches.size(), 1u);
    EXPECT_GT(following(d.strips, direction, other), 0.8) << degrees;
  }
}

// Along the axis of a tube the rulings cost nothing; the cross has an arm there, whichever one is given.
TEST(UserField, RulingsOfATubeFollowTheArmThatIsStraight) {
  const TriangleSoup soup = shapes::cylinder_patch(24, 12);
  DecomposeParams params;
  params.effort = Effort::kDraft;
  const Vector3 axis(0, 0, 1);
  UserField field;
  for (const Vector3& p : soup.points) field.per_vertex.push_back(Vector3(-p.y(), p.x(), 0));
  const UserField along = everywhere(soup, axis);
  for (const UserField* f : {static_cast<const UserField*>(&field), &along}) {
    const Decomposition d = run(soup, params, 2, f);
    expect_sound(soup, d);
    EXPECT_TRUE(d.report.e_max_met);
    EXPECT_GT(following(d.strips, axis, axis), 0.95);
  }
}

}  // namespace
}  // namespace sheetform
