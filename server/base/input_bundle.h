// A mesh and what the user gives to guide its cuts, as one run of bytes: they are stored, hashed and handed
// to a job as one input, so that a job never sees one without the other.
//
// The mesh alone; or the mesh, the cross field, and a tail of kTailBytes that says how long the mesh is; or
// the mesh, the field (may be empty), the strokes, how long the field is, and such a tail.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace sheetform::server {

/// Largest field that is taken: directions of about a million faces.
inline constexpr std::size_t kFieldFileBytes = std::size_t{32} << 20;
/// Largest file of strokes that is taken: more points than it may have.
inline constexpr std::size_t kGuidesFileBytes = std::size_t{4} << 20;
inline constexpr std::size_t kTailBytes = 40;

struct InputBundle {
  std::string_view mesh, field, guides;  ///< field and guides empty: none were given
};

/// What follows the mesh; empty for an empty field and no guides.
std::string after_mesh(std::uint64_t mesh_bytes, std::string_view field, std::string_view guides = {});
/// Bytes of the mesh in a bundle of `bytes` that ends with `tail` (its last kTailBytes, or all of it).
std::uint64_t mesh_bytes_of(std::uint64_t bytes, std::string_view tail);
InputBundle split_bundle(std::string_view bytes);

}  // namespace sheetform::server
