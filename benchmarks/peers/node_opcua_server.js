// A server of node-opcua with two loops; FIC102 has no node for its PV.
const opcua = require("node-opcua");

async function main() {
  const folder = process.argv[2];
  const server = new opcua.OPCUAServer({
    port: 0,
    hostname: "127.0.0.1",
    securityPolicies: [opcua.SecurityPolicy.None],
    securityModes: [opcua.MessageSecurityMode.None],
    serverCertificateManager: new opcua.OPCUACertificateManager({ rootFolder: folder + "/pki" }),
  });
  await server.initialize();
  const space = server.engine.addressSpace.getOwnNamespace();
  const plant = space.addFolder("ObjectsFolder", { browseName: "Plant" });
  const nodes = {};
  for (const name of ["FIC101.PV", "FIC101.OP", "FIC102.OP"])
    nodes[name] = space.addVariable({
      componentOf: plant, nodeId: `s=${name}`, browseName: name, dataType: "Double",
      value: { dataType: "Double", value: 50 },
    });
  setInterval(() => {
    const t = Date.now() / 1000;
    for (const [name, node] of Object.entries(nodes))
      node.setValueFromSource({ dataType: "Double", value: name.endsWith("PV") ? 50 + 5 * Math.sin(t) : 50 - 5 * Math.cos(t) });
  }, 50);
  await server.start();
  console.log(JSON.stringify({ port: server.endpoints[0].port, namespace: space.index }));
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
