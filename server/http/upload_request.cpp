#include "server/http/upload_request.h"

#include <algorithm>
#include <array>

#include "server/base/input_bundle.h"
#include "server/http/field_text.h"
#include "server/http/multipart.h"
#include "server/mapping/errors.h"
#include "server/mapping/wire_parameters.h"
#include "sheetform_api/parameter_schema.h"
#include "sheetform_api/process.h"

namespace sheetform::server {
namespace {

using api::ProblemType;

constexpr std::size_t kTagBytes = 100, kFieldBytes = 64 * 1024, kKeyBytes = 255, kNameBytes = 255;
constexpr std::size_t kTypeBytes = 127;  // RFC 6838 allows as many for each of its two words
/// What curl and others call a raw file when they are told nothing better.
constexpr std::array<std::string_view, 4> kRawTypes{"", "application/octet-stream",
                                                    "application/x-www-form-urlencoded", "text/plain"};
constexpr std::array<std::string_view, 9> kMeshTypes{
    "application/x-ply",          "application/ply",    "application/sla",
    "application/vnd.ms-pki.stl", "application/x-stl",  "application/object",
    "application/wavefront-obj",  "application/x-tgif", "application/prs.wavefront-obj"};

std::string media_type_of(const RequestHead& head) {
  const std::string field = head.field("content-type");
  return lower(trimmed(std::string_view(field).substr(0, field.find(';'))));
}

bool is_raw_mesh(const std::string& type) {
  return (type.rfind("model/", 0) == 0 && type.size() <= kTypeBytes) ||
         std::find(kRawTypes.begin(), kRawTypes.end(), type) != kRawTypes.end() ||
         std::find(kMeshTypes.begin(), kMeshTypes.end(), type) != kMeshTypes.end();
}

/// What a request says besides the mesh, however it says it. Each thing may be said once.
class Details {
 public:
  explicit Details(std::string process) : process_(std::move(process)) {}

  void take_text(const std::string& name, const std::string& value) {
    if (name == "tag") return take_tag(value);
    if (name == "filename") return void(name_ = display_name(value));
    if (name == "cache") return take_cache(value);
    const api::ParameterDefinition* d = api::find_parameter(name);
    if (d == nullptr) refuse_unknown(name);
    take_value(name, parameter_value(*d, value));
  }
  void take_json(const api::Json& parameters) {
    for (const auto& [name, value] : parameters.items()) take_value(name, value);
  }
  void take_tag(const std::string& tag) {
    if (tag.size() > kTagBytes)
      throw Refusal(ProblemType::kInvalidParameter, "the tag is longer than 100 bytes", "shorten it", "tag");
    if (std::any_of(tag.begin(), tag.end(), is_control))
      throw Refusal(ProblemType::kInvalidParameter, "the tag holds a control character",
                    "write it on one line, without tabs", "tag");
    tag_ = tag;
  }
  void take_name(const std::string& name) {
    if (name_.empty()) name_ = display_name(name);
  }

  /// Refuses what is wrong already; of what is missing, only what cannot come with the body any more.
  void check(bool more_to_come) const {
    if (!more_to_come || !sweep() || values_.contains(api::kTolerance)) (void)submission();
  }
  Submission submission() const {
    Submission s;
    s.process = process_;
    s.name = name_;
    s.tag = tag_;
    s.refresh = refresh_;
    s.parameters = sweep() ? understood_sweep_parameters(values_) : understood_parameters(values_);
    return s;
  }

 private:
  bool sweep() const { return process_ == api::kSweep; }
  [[noreturn]] void refuse_unknown(const std::string& name) const {
    const std::string like = api::similar_parameters(name);
    throw Refusal(ProblemType::kInvalidParameter, "there is no parameter " + name.substr(0, 60),
                  (like.empty() ? "" : "you may mean " + like + "; ") + "there are " + all_names() +
                      "; see /api/v1/processes/" + process_,
                  name.substr(0, 60));
  }
  std::string all_names() const {
    std::string names = "tag, filename, cache";
    for (const api::ParameterDefinition& d : api::parameter_definitions())
      if (!sweep() || api::is_sweep_parameter(d.name)) names += ", " + d.name;
    return names;
  }
  api::Json parameter_value(const api::ParameterDefinition& d, const std::string& text) const {
    try {
      return sweep() && d.name == api::kTolerance ? api::sweep_tolerances_from_text(text)
                                                  : api::parameter_from_text(d, text);
    } catch (const api::InvalidParameter& e) {
      throw to_core_error(e);
    }
  }
  void take_value(const std::string& name, const api::Json& value) {
    if (values_.contains(name))
      throw Refusal(ProblemType::kInvalidParameter, "the parameter is given twice", "give it once",
                    name.substr(0, 60));
    values_[name] = value;
  }
  void take_cache(const std::string& value) {
    if (value != "prefer" && value != "refresh")
      throw Refusal(ProblemType::kInvalidParameter, "cache is neither prefer nor refresh", "give one of them",
                    "cache");
    refresh_ = value == "refresh";
  }

  const std::string process_;
  api::Json values_ = api::Json::object();
  std::string name_, tag_;
  bool refresh_ = false;
};

[[noreturn]] void refuse_body(const std::string& detail, const std::string& where = {},
                              const std::string& fix = "see /api/v1/api") {
  throw Refusal(ProblemType::kMalformedRequest, detail, fix, where);
}

std::unique_ptr<Upload> read_raw(Exchange& exchange, JobService& service) {
  exchange.body.set_limit(service.limits().upload_bytes);
  std::unique_ptr<Upload> upload = service.begin_upload();
  for (std::string_view piece; !(piece = exchange.body.read()).empty();) upload->add(piece);
  return upload;
}

constexpr const char* kMeshPart = "name the part with the mesh `mesh`, e.g. curl -F mesh=@lamp.stl";

constexpr const char* kWholeForm =
    "let the client write the form, e.g. curl -F mesh=@lamp.stl -F e_max=0.02; only mesh, field and guides "
    "are files";

/// curl sends the name in place of the file when the @ before it was forgotten.
bool is_name_of_file(const std::string& text) {
  const std::size_t dot = text.rfind('.');
  if (dot == std::string::npos || text.find('\n') != std::string::npos) return false;
  const std::string ending = lower(text.substr(dot + 1));
  return ending == "obj" || ending == "stl" || ending == "ply" || ending == "off";
}

/// The parts of a form, each where it belongs.
class Form {
 public:
  Form(JobService& service, Details& details) : service_(service), details_(details) {}

  void begin(const PartHead& part) {
    part_ = part;
    text_.clear();
    if (part.is_file && part.name != "mesh" && part.name != "field" && part.name != "guides" &&
        part.name != "request")
      refuse_body("the part " + part.name.substr(0, 60) + " holds a file", part.name.substr(0, 60),
                  kMeshPart);
    if (part.name != "mesh") return;
    if (upload_) refuse_body("there is more than one part mesh", "mesh");
    upload_ = service_.begin_upload();
    details_.take_name(part.filename);
  }
  void data(std::string_view bytes) {
    if (part_.name == "mesh") {
      upload_->add(bytes);
      if (!part_.is_file && words_.size() < kNameBytes) words_.append(bytes.substr(0, kNameBytes));
      return;
    }
    text_.append(bytes);
    const std::size_t most = part_.name == "field"    ? kFieldFileBytes
                             : part_.name == "guides" ? kGuidesFileBytes
                                                      : kFieldBytes;
    if (text_.size() > most) refuse_body("a part of the form is too large", part_.name.substr(0, 60));
  }
  void end() {
    if (part_.name == "mesh") return;
    if (part_.name == "request") return take_request();
    if (text_.empty()) return;  // an empty field of a form is a field left alone
    if (part_.name == "field") return keep_beside(directions_);
    if (part_.name == "guides") return keep_beside(guides_);
    details_.take_text(part_.name, text_);
  }
  std::unique_ptr<Upload> take() {
    if (!upload_) refuse_body("the form has no part mesh", "mesh", kMeshPart);
    if (upload_->bytes() == words_.size() && is_name_of_file(words_))
      refuse_body("the part mesh holds the name of a file, not the file", "mesh",
                  std::string(kMeshPart) + ", with the @");
    upload_->add(after_mesh(upload_->bytes(), directions_, guides_));
    return std::move(upload_);
  }

 private:
  // The cross field or the strokes: they follow the mesh in what is stored.
  void keep_beside(std::string& kept) {
    const std::string name = part_.name;
    if (!kept.empty()) refuse_body("there is more than one part " + name, name);
    kept = std::move(text_);
  }
  void take_request() {
    api::Json value;
    std::string why;
    if (!api::parse_json(text_, value, why) || !value.is_object())
      refuse_body("the part request " + why, "request");
    // Either the parameters themselves or an OGC request without the mesh.
    if (value.contains("tag") && value["tag"].is_string()) details_.take_tag(value["tag"]);
    const api::Json parameters = value.contains("inputs") ? value["inputs"] : value;
    if (!parameters.is_object()) refuse_body("inputs is not an object", "request");
    for (const auto& [name, member] : parameters.items())
      if (name != "tag" && name != "mesh") details_.take_json({{name, member}});
  }

  JobService& service_;
  Details& details_;
  PartHead part_;
  std::string text_, directions_, guides_;
  std::string words_;  ///< how a mesh begins that was not sent as a file
  std::unique_ptr<Upload> upload_;
};

std::unique_ptr<Upload> read_form(Exchange& exchange, JobService& service, Details& details) {
  const std::string boundary = multipart_boundary(exchange.head.field("content-type"));
  if (boundary.empty())
    refuse_body("the boundary of the form is missing or wrong", "Content-Type",
                "let the client write Content-Type itself, e.g. curl -F mesh=@lamp.stl");
  Form form(service, details);
  MultipartReader reader(boundary, {[&](const PartHead& part) { form.begin(part); },
                                    [&](std::string_view bytes) { form.data(bytes); }, [&] { form.end(); }});
  exchange.body.set_limit(service.limits().upload_bytes + kFieldBytes);
  for (std::string_view piece; !(piece = exchange.body.read()).empty();)
    if (!reader.add(piece)) refuse_body(reader.error(), {}, kWholeForm);
  if (!reader.complete()) refuse_body(reader.error(), {}, kWholeForm);
  return form.take();
}

constexpr const char* kJsonBody =
    "give {\"inputs\": {\"mesh\": \"the file in base64\", \"e_max\": 0.02}}, or send the file itself: curl "
    "--data-binary @lamp.stl";

/// JSON is held in memory, and may be smaller than a mesh that comes as it is.
std::string json_text(Exchange& exchange, const ServiceLimits& limits) {
  try {
    exchange.body.set_limit(limits.json_bytes);
    return exchange.body.read_all();
  } catch (const BodyError& e) {
    if (e.type() != ProblemType::kPayloadTooLarge) throw;
    throw Refusal(e.type(), e.what(),
                  "send the mesh as it is, or in a form: then it may have " +
                      std::to_string(limits.upload_bytes) + " bytes");
  }
}

std::unique_ptr<Upload> read_json(Exchange& exchange, JobService& service, Details& details) {
  api::Json value;
  std::string why;
  if (!api::parse_json(json_text(exchange, service.limits()), value, why))
    refuse_body("the body " + why, {}, kJsonBody);
  api::ExecuteRequest request;
  api::Problem problem;
  if (!api::read_execute_request(value, request, problem)) throw Refusal(problem);
  if (!request.tag.empty()) details.take_tag(request.tag);
  details.take_name(request.mesh_name);
  std::string guides;
  if (const auto given = request.parameters.find("guides"); given != request.parameters.end()) {
    guides = api::dump(*given);
    request.parameters.erase(given);
  }
  details.take_json(request.parameters);
  std::string bytes;
  if (!from_base64(request.mesh_base64, bytes))
    refuse_body("the mesh is not base64", "inputs.mesh",
                "give the bytes of the file in base64, without line breaks, or send the file itself: curl "
                "--data-binary @lamp.stl");
  std::unique_ptr<Upload> upload = service.begin_upload();
  upload->add(bytes);
  upload->add(after_mesh(bytes.size(), {}, guides));
  return upload;
}

void check_digest(const RequestHead& head, Sha256& whole) {
  const std::string field = head.field("content-digest");
  const std::size_t at = field.find("sha-256=:");
  if (at == std::string::npos) return;
  const std::size_t begin = at + 9, end = field.find(':', begin);
  std::string wanted;
  if (end == std::string::npos || !from_base64(field.substr(begin, end - begin), wanted))
    refuse_body("Content-Digest is malformed", "Content-Digest");
  if (wanted != whole.finish())
    throw Refusal(ProblemType::kDigestMismatch, "the body that arrived is not the one that was sent",
                  "send it again", "Content-Digest");
}

std::string idempotency_key(const RequestHead& head) {
  if (!head.has("idempotency-key")) return {};
  const std::string key = head.field("idempotency-key");
  const bool good = !key.empty() && key.size() <= kKeyBytes &&
                    std::all_of(key.begin(), key.end(), [](char c) { return c > 0x20 && c < 0x7f; });
  if (!good)
    refuse_body("Idempotency-Key must be 1 to 255 printable characters", "Idempotency-Key",
                "make up a new one for each job, as uuidgen does");
  return key;
}

}  // namespace

UploadRequest read_upload_request(Exchange& exchange, JobService& service) {
  const std::string type = media_type_of(exchange.head);
  const bool json = type == "application/json", form = type == "multipart/form-data";
  if (!json && !form && !is_raw_mesh(type))
    throw Refusal(
        ProblemType::kUnsupportedMediaType, "a body of type " + type.substr(0, 60) + " is not understood",
        "send the mesh as application/octet-stream, multipart/form-data or application/json", "Content-Type");
  if (exchange.head.has("content-encoding"))
    throw Refusal(ProblemType::kUnsupportedMediaType, "coded bodies are not understood",
                  "unpack the file and send it without Content-Encoding", "Content-Encoding");
  Details details(exchange.captures.at(0));
  for (const auto& [name, value] : exchange.query) details.take_text(name, value);
  details.check(json || form);  // wrong parameters are refused before the upload
  const std::string key = idempotency_key(exchange.head);
  Sha256 whole;
  if (exchange.head.has("content-digest")) exchange.body.hash_into(whole);  // costs as much as all the rest
  UploadRequest request;
  request.upload = json   ? read_json(exchange, service, details)
                   : form ? read_form(exchange, service, details)
                          : read_raw(exchange, service);
  request.submission = details.submission();
  check_digest(exchange.head, whole);
  request.submission.principal = exchange.principal.id;
  request.submission.idempotency_key = key;
  request.submission.route = exchange.head.path;
  return request;
}

}  // namespace sheetform::server
