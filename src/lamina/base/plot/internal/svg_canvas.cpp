// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/plot/internal/svg_canvas.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "lamina/base/core/number_text.h"

namespace lamina {

std::string svg_number(double value) {
  std::string text = printf_text("%.2f", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string svg_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else if (static_cast<unsigned char>(c) < 32)
      escaped += ' ';
    else
      escaped += c;
  }
  return escaped;
}

double text_width(std::string_view text, double font_size) {
  constexpr std::string_view narrow = "iljtfrI.,:;!|()[] '-/";
  constexpr std::string_view wide = "mwMWGOQ@%";
  double ems = 0.0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0) == 0x80) continue;  // the rest of a character of several bytes
    if (narrow.find(c) != std::string_view::npos)
      ems += 0.38;
    else if (wide.find(c) != std::string_view::npos)
      ems += 0.92;
    else
      ems += byte >= 'A' && byte <= 'Z' ? 0.70 : 0.62;
  }
  return ems * font_size;
}

namespace {

std::string attribute(std::string_view name, double value) {
  return " " + std::string(name) + "=\"" + svg_number(value) + "\"";
}

}  // namespace

void SvgCanvas::line(double x0, double y0, double x1, double y1, std::string_view color,
                     double width) {
  path("M" + svg_number(x0) + " " + svg_number(y0) + "L" + svg_number(x1) + " " + svg_number(y1),
       "stroke=\"" + std::string(color) + "\"" + attribute("stroke-width", width));
}

void SvgCanvas::rectangle(double x, double y, double width, double height,
                          std::string_view attributes) {
  body_ += "<rect" + attribute("x", x) + attribute("y", y) + attribute("width", width) +
           attribute("height", height) + " " + std::string(attributes) + "/>\n";
}

void SvgCanvas::circle(double x, double y, double radius, std::string_view attributes) {
  body_ += "<circle" + attribute("cx", x) + attribute("cy", y) + attribute("r", radius) + " " +
           std::string(attributes) + "/>\n";
}

void SvgCanvas::image(double x, double y, double width, double height, std::string_view address) {
  body_ += "<image" + attribute("x", x) + attribute("y", y) + attribute("width", width) +
           attribute("height", height) + " href=\"" + std::string(address) + "\"/>\n";
}

void SvgCanvas::path(std::string_view data, std::string_view attributes) {
  body_ += "<path d=\"" + std::string(data) + "\" " + std::string(attributes) + "/>\n";
}

void SvgCanvas::text(double x, double y, std::string_view text, const TextStyle& style,
                     std::string_view raised) {
  if (text.empty()) return;
  if (style.has_halo) {
    begin_group("stroke=\"#ffffff\" stroke-width=\"3\"");
    TextStyle rim = style;
    rim.has_halo = false;
    rim.color = "#ffffff";
    this->text(x, y, text, rim, raised);
    end_group();
  }
  constexpr std::array<const char*, 3> anchors = {"start", "middle", "end"};
  body_ += "<text" + attribute("x", x) + attribute("y", y) + attribute("font-size", style.size);
  body_ += std::string(" text-anchor=\"") + anchors[static_cast<std::size_t>(style.anchor)] + "\"";
  body_ += " fill=\"" + std::string(style.color) + "\"";
  if (style.is_bold) body_ += " font-weight=\"bold\"";
  if (style.turn != 0.0)
    body_ += " transform=\"rotate(" + svg_number(style.turn) + " " + svg_number(x) + " " +
             svg_number(y) + ")\"";
  body_ += ">" + svg_escaped(text);
  if (!raised.empty())
    body_ += "<tspan" + attribute("dy", -0.42 * style.size) +
             attribute("font-size", 0.74 * style.size) + ">" + svg_escaped(raised) + "</tspan>";
  body_ += "</text>\n";
}

void SvgCanvas::begin_group(std::string_view attributes) {
  body_ += "<g " + std::string(attributes) + ">\n";
}

void SvgCanvas::end_group() { body_ += "</g>\n"; }

void SvgCanvas::begin_clip(double x, double y, double width, double height) {
  const std::string name = "data" + std::to_string(++clips_);
  body_ += "<clipPath id=\"" + name + "\"><rect" + attribute("x", x) + attribute("y", y) +
           attribute("width", width) + attribute("height", height) + "/></clipPath>\n";
  begin_group("clip-path=\"url(#" + name + ")\"");
}

std::string SvgCanvas::finish(double width, double height) const {
  const std::string w = svg_number(std::ceil(width)), h = svg_number(std::ceil(height));
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
         w + "\" height=\"" + h + "\" viewBox=\"0 0 " + w + " " + h +
         "\" font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\" "
         "fill=\"none\" stroke-linejoin=\"round\">\n<rect width=\"" +
         w + "\" height=\"" + h + "\" fill=\"#ffffff\"/>\n" + body_ + "</svg>\n";
}

}  // namespace lamina
