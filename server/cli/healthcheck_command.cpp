// `sheetform healthcheck`: for images without curl.
#include <cstdio>

#include "server/cli/commands.h"
#include "server/http/health_client.h"
#include "server/mapping/errors.h"

namespace sheetform::server {
namespace {

constexpr std::chrono::seconds kPatience{3};

}  // namespace

CommandSpec healthcheck_spec() {
  CommandSpec spec;
  spec.name = "healthcheck";
  spec.usage = "[--listen 127.0.0.1:8080] [--ready]";
  spec.text = "Asks the server at the address whether it works; exit status 0 when it does.";
  spec.options = {{"--listen", "HOST:PORT", "Address of the server. Default 127.0.0.1:8080.", ""},
                  {"--ready", "", "Ask whether it takes new jobs as well.", ""}};
  return spec;
}

int healthcheck_command(const ParsedLine& line) {
  ListenAddress address;
  if (!parse_address(line.get("--listen", "127.0.0.1:8080"), address))
    throw Error(ErrorCode::kInvalidParameter, "this is no address", "--listen", "write HOST:PORT");
  const int status = ask_status(address, line.has("--ready") ? "/readyz" : "/healthz", kPatience);
  if (status == 200) return kExitOk;
  std::fprintf(stderr, "sheetform: the server at %s %s\n", address.text().c_str(),
               status == 0 ? "does not answer" : "is not well");
  return kExitOurs;
}

}  // namespace sheetform::server
