"""What MQTT messages say: values of tags with their times and qualities, in the forms of gateways."""
