#include "server/http/health_client.h"

#include <httplib.h>

namespace sheetform::server {

int ask_status(const ListenAddress& address, const std::string& path, std::chrono::seconds patience) {
  httplib::Client client(address.host, address.port);
  client.set_connection_timeout(patience.count());
  client.set_read_timeout(patience.count());
  const httplib::Result answer = client.Get(path);
  return answer ? answer->status : 0;
}

}  // namespace sheetform::server
