// Reading meshes that nobody has checked: OBJ, STL, PLY and OFF, all numbers in double precision.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sheetform/mesh/surface_mesh.h"

namespace sheetform {

/// What a file may hold at most. Exceeding a limit is Error kLimitExceeded; nothing is truncated silently.
struct ReadLimits {
  std::uint64_t bytes = std::uint64_t{256} << 20;
  std::uint64_t vertices = 5'000'000;
  std::uint64_t faces = 10'000'000;       ///< triangles, after polygons were split
  std::uint64_t polygon_sides = 100'000;  ///< of one polygon
  double coordinate = 1e9;                ///< largest absolute value, in the file's unit
};

/// A mesh file as it was written, polygons split into triangles; not welded (but STL, which has no indices,
/// by exact position), not repaired. Indices are in range, coordinates finite.
struct MeshFile {
  TriangleSoup soup;
  std::string format;              ///< "obj", "stl", "ply" or "off"
  std::vector<int> polygon;        ///< for each triangle the file's face (0-based, skipped ones counted)
  std::vector<std::string> notes;  ///< what was read otherwise than written, for people
};

/// Reads a mesh from memory. The format is told by the content; the name (a path, a file name or an ending)
/// only helps where that is not clear. Never opens other files (mtllib and the like are ignored); O(bytes)
/// time; memory in proportion to the bytes that are there, whatever counts a header announces. Throws Error
/// kUnreadableMesh (where: "line 12" or "byte 345") or kLimitExceeded.
MeshFile read_mesh(std::string_view bytes, std::string_view name_hint = {}, const ReadLimits& limits = {});

/// Reads at most limits.bytes of a file and calls read_mesh. Throws as it does, and when the file cannot be
/// read.
MeshFile read_mesh_file(const std::filesystem::path& path, const ReadLimits& limits = {});

/// OBJ text with coordinates that read back to the same doubles.
std::string write_obj(const TriangleSoup& soup);

}  // namespace sheetform
