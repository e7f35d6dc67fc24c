// Elements of XML one after the other, as text.
#pragma once

#include <tinyxml2.h>

#include <string>
#include <utility>
#include <vector>

namespace sinew::exporting {

class XmlText {
 public:
  using Attributes = std::vector<std::pair<const char*, std::string>>;

  void open(const char* tag, const Attributes& attributes = {}) {
    printer_.OpenElement(tag);
    for (const auto& [name, value] : attributes) printer_.PushAttribute(name, value.c_str());
  }
  void close() { printer_.CloseElement(); }
  /// One that holds nothing.
  void element(const char* tag, const Attributes& attributes) {
    open(tag, attributes);
    close();
  }
  std::string text() const { return printer_.CStr(); }

 private:
  tinyxml2::XMLPrinter printer_;
};

}  // namespace sinew::exporting
