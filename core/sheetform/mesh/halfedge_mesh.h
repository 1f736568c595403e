// The half-edge kernel that remeshing edits: OpenMesh's connectivity. Points are kept beside it, in double
// precision. Internal to mesh/.
#pragma once
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

namespace sheetform {

struct KernelTraits : OpenMesh::DefaultTraits {
  VertexAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::PrevHalfedge);
};
using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<KernelTraits>;

}  // namespace sheetform
