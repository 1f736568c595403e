#include "sheetform/blueprint/pdf_file.h"

#include <array>
#include <cmath>
#include <cstdint>

#include "sheetform/blueprint/text.h"
#include "sheetform/blueprint/zip.h"

namespace sheetform {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;
constexpr double kCapHeight = 0.718;  // of Helvetica's font size (its AFM)

// Advance widths of Helvetica from ' ' to '~', in thousandths of the font size (Adobe's AFM).
constexpr std::array<int, 95> kWidths = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};

// Code points of a valid UTF-8 text.
std::vector<std::uint32_t> code_points(const std::string& text) {
  const std::string good = valid_utf8(text);
  std::vector<std::uint32_t> out;
  for (char c : good) {
    const auto byte = static_cast<std::uint8_t>(c);
    if ((byte & 0xC0) == 0x80)
      out.back() = (out.back() << 6) | (byte & 0x3F);
    else
      out.push_back(byte < 0x80 ? byte : byte < 0xE0 ? byte & 0x1F : byte < 0xF0 ? byte & 0x0F : byte & 0x07);
  }
  return out;
}

std::string latin1(const std::string& text) {
  std::string out;
  for (std::uint32_t c : code_points(text))
    out += c >= 0x20 && c < 0x100 && !(c >= 0x7F && c < 0xA0) ? static_cast<char>(c) : '?';
  return out;
}

// A literal string in hex: nothing in it can be syntax.
std::string hex_string(const std::string& bytes) {
  std::string out = "<";
  for (char c : bytes) {
    const auto byte = static_cast<std::uint8_t>(c);
    out += "0123456789ABCDEF"[byte >> 4];
    out += "0123456789ABCDEF"[byte & 15];
  }
  return out + ">";
}

// Text of the document (titles, names): UTF-16 with a byte order mark.
std::string text_string(const std::string& utf8) {
  std::string bytes = "\xFE\xFF";
  const auto unit = [&](std::uint32_t u) {
    bytes += static_cast<char>(u >> 8), bytes += static_cast<char>(u & 0xFF);
  };
  for (std::uint32_t c : code_points(utf8)) {
    if (c < 0x10000)
      unit(c);
    else
      unit(0xD800 + ((c - 0x10000) >> 10)), unit(0xDC00 + ((c - 0x10000) & 0x3FF));
  }
  return hex_string(bytes);
}

std::string colour_of(const std::string& hex) {
  const auto part = [&](int at) {
    return rounded(std::stoi(hex.substr(static_cast<std::size_t>(at), 2), nullptr, 16) / 255.0, 4);
  };
  return part(1) + ' ' + part(3) + ' ' + part(5);
}

/// Objects one after another with their offsets.
class Objects {
 public:
  int reserve() {
    offsets_.push_back(0);
    return static_cast<int>(offsets_.size());
  }
  void put(int id, const std::string& body) {
    offsets_[static_cast<std::size_t>(id) - 1] = out_.size();
    out_ += std::to_string(id) + " 0 obj\n" + body + "\nendobj\n";
  }
  void put_stream(int id, const std::string& content, const std::string& entries = {}) {
    const std::string packed = deflated(content);
    put(id, "<< " + entries + " /Length " + std::to_string(packed.size()) +
                " /Filter /FlateDecode >>\nstream\n" + packed + "\nendstream");
  }
  std::string finish(int catalog, int info) {
    const std::size_t start = out_.size();
    out_ += "xref\n0 " + std::to_string(offsets_.size() + 1) + "\n0000000000 65535 f \n";
    for (std::size_t offset : offsets_) {
      const std::string digits = std::to_string(offset);
      out_ += std::string(10 - digits.size(), '0') + digits + " 00000 n \n";
    }
    out_ += "trailer\n<< /Size " + std::to_string(offsets_.size() + 1) + " /Root " + ref(catalog) +
            " /Info " + ref(info) + " >>\nstartxref\n" + std::to_string(start) + "\n%%EOF\n";
    return std::move(out_);
  }
  static std::string ref(int id) { return std::to_string(id) + " 0 R"; }

 private:
  std::string out_ = "%PDF-1.6\n%\xE2\xE3\xCF\xD3\n";
  std::vector<std::size_t> offsets_;
};

}  // namespace

void PdfPage::number(double value) {
  append_rounded(content_, value, 4);
  content_ += ' ';
}

void PdfPage::point(const Vector2& p) { number(p.x()), number(p.y()); }

void PdfPage::pen(const std::string& colour, double width) {
  content_ += colour_of(colour) + " RG ";
  number(width);
  content_ += "w\n";
}

void PdfPage::line(const std::vector<Vector2>& points, bool closed) {
  for (std::size_t i = 0; i < points.size(); ++i) point(points[i]), content_ += i == 0 ? "m\n" : "l\n";
  content_ += closed ? "s\n" : "S\n";
}

void PdfPage::fill(const std::vector<Vector2>& points, const std::string& colour) {
  content_ += colour_of(colour) + " rg\n";
  for (std::size_t i = 0; i < points.size(); ++i) point(points[i]), content_ += i == 0 ? "m\n" : "l\n";
  content_ += "f\n";
}

void PdfPage::text(const Vector2& at, const std::string& utf8, double size) {
  content_ += "0 0 0 rg BT /F1 ";
  number(size / kCapHeight);
  content_ += "Tf ";
  point(at);
  content_ += "Td " + hex_string(latin1(utf8)) + " Tj ET\n";
}

void PdfPage::image(const Vector2& low, const Vector2& high, PdfImage image) {
  content_ += "q ";
  number(high.x() - low.x()), content_ += "0 0 ", number(high.y() - low.y()), point(low);
  content_ += "cm /I" + std::to_string(images_.size()) + " Do Q\n";
  images_.push_back(std::move(image));
}

void PdfPage::begin_clip(const Vector2& low, const Vector2& high) {
  content_ += "q ";
  point(low), point(high - low);
  content_ += "re W n\n";
}

void PdfPage::end_clip() { content_ += "Q\n"; }
void PdfPage::begin_layer(int layer) { content_ += "/OC /L" + std::to_string(layer) + " BDC\n"; }
void PdfPage::end_layer() { content_ += "EMC\n"; }

int PdfFile::add_layer(const std::string& name) {
  layers_.push_back(name);
  return static_cast<int>(layers_.size()) - 1;
}

std::string PdfFile::write() const {
  Objects objects;
  const int catalog = objects.reserve(), tree = objects.reserve(), font = objects.reserve(),
            information = objects.reserve();
  std::vector<int> layers;
  std::string all_layers, layer_names;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    layers.push_back(objects.reserve());
    all_layers += Objects::ref(layers[i]) + ' ';
    layer_names += "/L" + std::to_string(i) + ' ' + Objects::ref(layers[i]) + ' ';
  }
  objects.put(catalog, "<< /Type /Catalog /Pages " + Objects::ref(tree) +
                           " /ViewerPreferences << /PrintScaling /None >>" + " /OCProperties << /OCGs [" +
                           all_layers + "] /D << /Order [" + all_layers + "] >> >> >>");
  objects.put(font, "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>");
  std::string info;
  for (const auto& [key, value] : info_) info += '/' + key + ' ' + text_string(value) + ' ';
  objects.put(information, "<< " + info + ">>");
  for (std::size_t i = 0; i < layers_.size(); ++i)
    objects.put(layers[i], "<< /Type /OCG /Name " + text_string(layers_[i]) + " >>");
  std::string kids;
  const std::string common =
      "/Font << /F1 " + Objects::ref(font) + " >> /Properties << " + layer_names + ">>";
  for (const PdfPage& page : pages_) {
    const int id = objects.reserve(), stream = objects.reserve();
    kids += Objects::ref(id) + ' ';
    std::string images;
    for (std::size_t i = 0; i < page.images_.size(); ++i) {
      const PdfImage& image = page.images_[i];
      const int at = objects.reserve();
      images += "/I" + std::to_string(i) + ' ' + Objects::ref(at) + ' ';
      objects.put_stream(
          at, image.pixels,
          "/Type /XObject /Subtype /Image /Width " + std::to_string(image.width) + " /Height " +
              std::to_string(image.height) + " /BitsPerComponent 8 /ColorSpace [/Indexed /DeviceRGB " +
              std::to_string(image.palette.size() / 3 - 1) + ' ' + hex_string(image.palette) + "]");
    }
    const std::string resources = "<< " + common + " /XObject << " + images + ">> >>";
    const std::string box = "[0 0 " + rounded(page.width_ * kPointsPerMm, 4) + ' ' +
                            rounded(page.height_ * kPointsPerMm, 4) + "]";
    objects.put(id, "<< /Type /Page /Parent " + Objects::ref(tree) + " /MediaBox " + box + " /TrimBox " +
                        box + " /Resources " + resources + " /Contents " + Objects::ref(stream) + " >>");
    const std::string unit = rounded(kPointsPerMm, 10);
    objects.put_stream(stream, unit + " 0 0 " + unit + " 0 0 cm 1 J 1 j\n" + page.content_);
  }
  objects.put(tree, "<< /Type /Pages /Kids [" + kids + "] /Count " + std::to_string(pages_.size()) + " >>");
  return objects.finish(catalog, information);
}

double helvetica_width(const std::string& utf8, double size) {
  double sum = 0;
  for (char c : latin1(utf8)) sum += c >= ' ' && c <= '~' ? kWidths[static_cast<std::size_t>(c - ' ')] : 600;
  return sum / 1000 * size / kCapHeight;
}

}  // namespace sheetform
