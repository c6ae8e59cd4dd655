// An alarm list of node-opcua: acknowledges the first alarm that it sees, shelves it, and tells what became of it.
const opcua = require("node-opcua-client");

const text = (alarm, field) => {
  const found = alarm.getField(field);
  return found && found.value && found.value.text !== undefined ? found.value.text : found && found.value;
};

async function until(condition) {
  for (const end = Date.now() + 60000; !condition(); ) {
    if (Date.now() > end) throw new Error(`not within a minute: ${condition}`);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

async function main(url) {
  const client = opcua.OPCUAClient.create({ endpointMustExist: false, applicationName: "third party" });
  await client.connect(url);
  const session = await client.createSession();
  const list = await opcua.installAlarmMonitoring(session);
  const alarm = () => list.alarms()[0];
  const told = { answers: [] };
  await until(() => list.length === 1);
  told.condition = alarm().conditionId.toString();
  told.message = text(alarm(), "message");
  const acknowledge = async (event) =>
    told.answers.push((await session.acknowledgeCondition(alarm().conditionId, event, "seen")).name);
  await acknowledge(Buffer.from("an old one"));
  await acknowledge(alarm().eventId);
  await until(() => text(alarm(), "ackedState") === "Acknowledged");
  told.comment = text(alarm(), "comment");
  const hour = [{ dataType: "Double", value: 3600000 }];
  const shelve = { objectId: alarm().conditionId, methodId: "i=2949", inputArguments: hour };
  told.answers.push((await session.call(shelve)).statusCode.name);
  await until(() => text(alarm(), "suppressedOrShelved") === true);
  await opcua.uninstallAlarmMonitoring(session);
  await session.close();
  await client.disconnect();
  console.log("TOLD " + JSON.stringify(told));
}

main(process.argv[2]).catch((error) => {
  console.error(error);
  process.exit(1);
});
