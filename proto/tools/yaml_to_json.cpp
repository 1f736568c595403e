// Turns a YAML file of the JSON schema (core tags only) into JSON: yaml_to_json IN OUT.
#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

namespace {

using Json = nlohmann::ordered_json;

Json scalar_to_json(const YAML::Node& node) {
  // A quoted scalar has the tag "!": it is text whatever it looks like.
  if (node.Tag() == "!") return node.Scalar();
  if (bool flag; YAML::convert<bool>::decode(node, flag)) return flag;
  if (std::int64_t number; YAML::convert<std::int64_t>::decode(node, number)) return number;
  if (double number; YAML::convert<double>::decode(node, number)) return number;
  return node.Scalar();
}

Json to_json(const YAML::Node& node) {
  if (node.IsScalar()) return scalar_to_json(node);
  if (node.IsSequence()) {
    Json list = Json::array();
    for (const YAML::Node& item : node) list.push_back(to_json(item));
    return list;
  }
  if (!node.IsMap()) return nullptr;
  Json object = Json::object();
  for (const auto& member : node) object[member.first.Scalar()] = to_json(member.second);
  return object;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: yaml_to_json IN OUT\n");
    return 64;
  }
  try {
    std::ofstream out(argv[2], std::ios::binary);
    out << to_json(YAML::LoadFile(argv[1])).dump(1) << '\n';
    return out.flush().good() ? 0 : 74;
  } catch (const YAML::Exception& e) {
    std::fprintf(stderr, "%s: %s\n", argv[1], e.what());
    return 65;
  }
}
